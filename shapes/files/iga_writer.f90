module iga_writer
  !! Any mesh of surfaces or volumes as text `.iga` (see iga_reader) that reads back bit for bit.
  !!
  !! The format has no place for curves, for elements of different dimension in one file, for names
  !! with blanks, and for negative zeros in operators; sets of whole elements as sides (shells) are
  !! written as sets of elements.
  use kinds, only: wp, i8
  use number_text, only: read_number
  use extraction_mesh, only: extraction_mesh_type, problem_list, whole_number, set_of_nodes, &
    set_of_elements, set_of_sides
  use iga_reader, only: side_words
  implicit none (type, external)
  private
  public :: write_iga, iga_problems

  type :: buffer_type
    !! A text that grows.
    character(:), allocatable :: text
    integer(i8) :: n = 0
  contains
    procedure :: reserve
    procedure :: put
    procedure :: put_again
    procedure :: put_number
    procedure :: put_whole
  end type buffer_type

contains

  subroutine iga_problems(mesh, problems)
    !! What of a mesh the format cannot hold.
    type(extraction_mesh_type), intent(in) :: mesh
    type(problem_list), intent(inout) :: problems

    integer :: dp, i, k

    if (mesh%elements%ne == 0) then
      call problems%add(0, 'the mesh has no elements', '')
      return
    end if
    dp = mesh%elements%dp(1)
    if (any(mesh%elements%dp(1:mesh%elements%ne) /= dp)) then
      call problems%add(0, 'elements of different dimension cannot be written as .iga', &
        'The form .h5 holds them')
    else if (dp < 2) then
      call problems%add(0, 'curves cannot be written as .iga', 'The form .h5 holds them')
    end if
    do i = 1, size(mesh%sets)
      associate (set => mesh%sets(i))
        if (scan(set%name, ' ,#' // achar(9) // achar(10) // achar(13)) > 0 .or. &
          len(set%name) == 0) call problems%add(0, 'the name of set "' // set%name // &
          '" cannot be written as .iga', 'Names there have no blanks, commas or #')
        if (set%kind /= set_of_sides) cycle
        if (all(set%sides > 0) .or. all(set%sides == 0)) cycle
        call problems%add(0, 'set "' // set%name // &
          '" has sides and whole elements, it cannot be written as .iga', 'Make two sets of it')
      end associate
      do k = 1, i - 1
        if (kind_word(i) == kind_word(k) .and. mesh%sets(i)%name == mesh%sets(k)%name .and. &
          .not. is_shell_copy(i, k)) call problems%add(0, 'there are two sets "' // &
          mesh%sets(i)%name // '" that would be one kind in .iga', 'Rename one')
      end do
    end do

  contains

    pure function kind_word(i)
      integer, intent(in) :: i
      character(4) :: kind_word

      kind_word = word_of_kind(mesh%sets(i)%kind, mesh%sets(i)%sides)
    end function kind_word

    pure logical function is_shell_copy(i, k)
      !! The same elements once as elements and once as a surface.
      integer, intent(in) :: i, k

      is_shell_copy = .false.
      if (mesh%sets(i)%kind == mesh%sets(k)%kind) return
      if (size(mesh%sets(i)%items) /= size(mesh%sets(k)%items)) return
      is_shell_copy = all(mesh%sets(i)%items == mesh%sets(k)%items)
    end function is_shell_copy
  end subroutine iga_problems

  pure function word_of_kind(kind, sides) result(word)
    integer, intent(in) :: kind, sides(:)
    character(4) :: word

    select case (kind)
    case (set_of_nodes);    word = 'node'
    case (set_of_elements); word = 'elem'
    case default
      word = 'side'
      if (size(sides) > 0) then
        if (all(sides == 0)) word = 'elem'
      end if
    end select
  end function word_of_kind

  subroutine write_iga(mesh, ndm, text)
    !! Only for a mesh without iga_problems.
    type(extraction_mesh_type), intent(in) :: mesh
    integer, intent(in) :: ndm                         !! space dimension: 2 makes it a plane
    character(:), allocatable, intent(out) :: text

    type(buffer_type) :: out
    character(4) :: word
    character(16) :: kind
    integer(i8), allocatable :: first(:), last(:)   !! where the rows of an operator stand (nop)
    integer(i8) :: at
    integer :: a, b, e, i, k, nen, op

    kind = 'volume'
    if (mesh%elements%dp(1) == 2) kind = 'surface'
    if (mesh%elements%dp(1) == 2 .and. ndm == 2) kind = 'plane'
    call out%put('type ' // trim(kind) // new_line('a'))
    call out%put('nodeN ' // whole_number(mesh%nn) // new_line('a'))
    call out%put('elemN ' // whole_number(mesh%elements%ne) // new_line('a'))
    do a = 1, mesh%nn
      call out%put('node')
      do i = 1, 3
        call out%put_number(mesh%x(i,a))
      end do
      call out%put_number(mesh%w(a))
      call out%put(new_line('a'))
    end do
    allocate (first(mesh%elements%nop), last(mesh%elements%nop), source=0_i8)
    do e = 1, mesh%elements%ne
      nen = mesh%elements%nen(e)
      call out%put('belem')
      call out%put_whole(nen)
      do i = 1, mesh%elements%dp(e)
        call out%put_whole(mesh%elements%degree(i,e))
      end do
      call out%put(new_line('a'))
      do k = mesh%elements%node_ptr(e), mesh%elements%node_ptr(e+1) - 1
        call out%put_whole(mesh%elements%nodes(k) - 1)
      end do
      call out%put(new_line('a'))
      op = mesh%elements%operator_of(e)
      if (last(op) > 0) then
        call out%put_again(first(op), last(op))
        cycle
      end if
      first(op) = out%n + 1
      do a = 1, nen
        do b = 1, mesh%elements%nb(e)
          at = mesh%elements%op_ptr(op) + (a - 1) + int(nen, i8)*(b - 1)
          call out%put_number(mesh%elements%coef(at))
        end do
        call out%put(new_line('a'))
      end do
      last(op) = out%n
    end do
    do i = 1, size(mesh%sets)
      associate (set => mesh%sets(i))
        word = word_of_kind(set%kind, set%sides)
        if (set%kind == set_of_sides .and. word == 'elem') then
          if (is_written(i)) cycle
        end if
        call out%put('set ' // whole_number(size(set%items)) // ' ' // word // ' ' // set%name)
        do k = 1, size(set%items)
          call out%put_whole(set%items(k) - 1)
          if (word == 'side') call out%put(' ' // trim(side_words(set%sides(k))))
        end do
        call out%put(new_line('a'))
      end associate
    end do
    text = out%text(1:out%n)

  contains

    pure logical function is_written(i)
      !! As a set of elements.
      integer, intent(in) :: i
      integer :: k

      is_written = .false.
      do k = 1, size(mesh%sets)
        is_written = is_written .or. (mesh%sets(k)%kind == set_of_elements .and. &
          mesh%sets(k)%name == mesh%sets(i)%name)
      end do
    end function is_written
  end subroutine write_iga

  pure subroutine reserve(self, needed)
    class(buffer_type), intent(inout) :: self
    integer(i8), intent(in) :: needed                  !! characters that there is room for then

    character(:), allocatable :: longer

    if (.not. allocated(self%text)) allocate (character(65536_i8) :: self%text)
    if (needed > len(self%text, i8)) then
      allocate (character(2*needed) :: longer)
      longer(1:self%n) = self%text(1:self%n)
      call move_alloc(longer, self%text)
    end if
  end subroutine reserve

  pure subroutine put(self, piece)
    class(buffer_type), intent(inout) :: self
    character(*), intent(in) :: piece

    call self%reserve(self%n + len(piece, i8))
    self%text(self%n+1:self%n+len(piece, i8)) = piece
    self%n = self%n + len(piece, i8)
  end subroutine put

  pure subroutine put_again(self, first, last)
    class(buffer_type), intent(inout) :: self
    integer(i8), intent(in) :: first, last             !! characters that are there already

    call self%reserve(self%n + last - first + 1)
    self%text(self%n+1:self%n+last-first+1) = self%text(first:last)
    self%n = self%n + last - first + 1
  end subroutine put_again

  pure subroutine put_whole(self, i)
    class(buffer_type), intent(inout) :: self
    integer, intent(in) :: i

    call self%put(' ' // whole_number(i))
  end subroutine put_whole

  pure subroutine put_number(self, x)
    !! A blank and 15 digits, or 17 where 15 do not read the same bits back.
    class(buffer_type), intent(inout) :: self
    real(wp), intent(in) :: x

    character(11), parameter :: forms(2) = ['(es26.14e3)', '(es26.16e3)']
    character(26) :: buffer
    real(wp) :: again
    integer :: i, used

    if (transfer(x, 0_i8) == 0_i8) then
      call self%put(' 0')
      return
    end if
    if (abs(x) < 1.0e6_wp .and. abs(x) > 0) then
      if (.not. abs(x - aint(x)) > 0) then
        call self%put_whole(int(x))
        return
      end if
    end if
    do i = 1, size(forms)
      write (buffer, forms(i)) x
      buffer = adjustl(buffer)
      call read_number(trim(buffer), again, used)
      if (used == len_trim(buffer) .and. transfer(again, 0_i8) == transfer(x, 0_i8)) exit
    end do
    call self%put(' ' // without_zeros(trim(buffer)))
  end subroutine put_number

  pure function without_zeros(number) result(text)
    !! 1.25 for 1.25000000000000E+000
    character(*), intent(in) :: number
    character(:), allocatable :: text

    integer :: e, last

    e = index(number, 'E')
    text = number
    if (e == 0) return
    last = verify(number(1:e-1), '0', back=.true.)
    if (number(last:last) == '.') last = last + 1
    text = number(1:last)
    if (number(e:) /= 'E+000') text = text // number(e:)
  end function without_zeros
end module iga_writer
