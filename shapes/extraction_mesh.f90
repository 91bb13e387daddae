module extraction_mesh
  !! A mesh as files of extraction operators hold it, whatever their format: control points,
  !! elements, named sets; and what is wrong with a file, as a list of line, fact and remedy.
  !! Nodes and elements are numbered from 1 here.
  use kinds, only: wp, i8
  use extraction_set, only: extraction_set_type
  use growing_arrays, only: make_room
  implicit none (type, external)
  private
  public :: extraction_mesh_type, mesh_set, file_problem, problem_list
  public :: set_of_nodes, set_of_elements, set_of_sides, largest_degree
  public :: check_elements, check_sets, repeated_elements, used_by_elements, names_a_node_twice, &
    whole_number, printable

  integer, parameter :: set_of_nodes = 1, set_of_elements = 2, set_of_sides = 3
  integer, parameter :: most_problems = 50      !! of a file that are kept
  integer, parameter :: largest_degree = 30     !! what is above is taken for a fault of the file

  type :: mesh_set
    character(:), allocatable :: name
    integer :: kind = 0                  !! set_of_nodes, set_of_elements, set_of_sides
    integer :: line = 0                  !! of the file
    integer, allocatable :: items(:)     !! nodes; elements; the elements of sides
    integer, allocatable :: sides(:)     !! side of each element, 1: s=0, 2: s=1, 3: t=0, 4: t=1,
                                         !! 5: u=0, 6: u=1, 0: the element itself; else empty
  end type mesh_set

  type :: file_problem
    integer :: line = 0                  !! 0: the file as a whole
    character(:), allocatable :: fact    !! without full stop
    character(:), allocatable :: remedy  !! may be ''
  end type file_problem

  type :: problem_list
    type(file_problem) :: list(most_problems)
    integer :: kept = 0
    integer :: count = 0                 !! of all problems
  contains
    procedure :: add => add_problem
  end type problem_list

  type :: extraction_mesh_type
    character(:), allocatable :: format  !! name of the file's format
    integer :: nn = 0                    !! nodes (control points)
    real(wp), allocatable :: x(:,:)      !! control points, Cartesian (3,nn) [length]
    real(wp), allocatable :: w(:)        !! control weights (nn)
    integer, allocatable :: node_line(:) !! line of each node in the file (nn)
    type(extraction_set_type) :: elements
    integer, allocatable :: element_line(:)   !! where each element begins in the file (ne)
    type(mesh_set), allocatable :: sets(:)
  contains
    procedure :: start
    procedure :: add_node
    procedure :: add_element
    procedure :: add_set
    procedure :: finish
  end type extraction_mesh_type

contains

  pure subroutine add_problem(self, line, fact, remedy)
    class(problem_list), intent(inout) :: self
    integer, intent(in) :: line
    character(*), intent(in) :: fact, remedy

    self%count = self%count + 1
    if (self%kept == most_problems) return
    self%kept = self%kept + 1
    self%list(self%kept)%line = line
    self%list(self%kept)%fact = fact
    self%list(self%kept)%remedy = remedy
  end subroutine add_problem

  subroutine start(self, format)
    !! Empties the mesh.
    class(extraction_mesh_type), intent(inout) :: self
    character(*), intent(in) :: format

    self%format = format
    self%nn = 0
    call self%elements%init()
    if (allocated(self%x)) deallocate (self%x, self%w, self%node_line)
    if (allocated(self%element_line)) deallocate (self%element_line)
    if (allocated(self%sets)) deallocate (self%sets)
    allocate (self%x(3,0), self%w(0), self%node_line(0), self%element_line(0), self%sets(0))
  end subroutine start

  subroutine add_node(self, x, w, line)
    class(extraction_mesh_type), intent(inout) :: self
    real(wp), intent(in) :: x(3)         !! Cartesian [length]
    real(wp), intent(in) :: w            !! weight
    integer, intent(in) :: line          !! of the file

    self%nn = self%nn + 1
    call make_room(self%x, self%nn)
    call make_room(self%w, self%nn)
    call make_room(self%node_line, self%nn)
    self%x(:,self%nn) = x
    self%w(self%nn) = w
    self%node_line(self%nn) = line
  end subroutine add_node

  subroutine add_element(self, degree, nodes, ce, line)
    class(extraction_mesh_type), intent(inout) :: self
    integer, intent(in) :: degree(:)     !! (dp)
    integer, intent(in) :: nodes(:)      !! (nen)
    real(wp), intent(in) :: ce(:,:)      !! (nen,nb)
    integer, intent(in) :: line          !! of the file

    integer :: id

    call self%elements%add_element(size(degree), degree, nodes, ce, id)
    call make_room(self%element_line, id)
    self%element_line(id) = line
  end subroutine add_element

  subroutine add_set(self, name, kind, line, items, sides)
    class(extraction_mesh_type), intent(inout) :: self
    character(*), intent(in) :: name
    integer, intent(in) :: kind          !! set_of_nodes, set_of_elements, set_of_sides
    integer, intent(in) :: line          !! of the file
    integer, intent(in) :: items(:), sides(:)

    type(mesh_set), allocatable :: longer(:)
    integer :: i, n

    n = size(self%sets)
    allocate (longer(n+1))
    do i = 1, n
      longer(i)%kind = self%sets(i)%kind
      longer(i)%line = self%sets(i)%line
      call move_alloc(self%sets(i)%name, longer(i)%name)
      call move_alloc(self%sets(i)%items, longer(i)%items)
      call move_alloc(self%sets(i)%sides, longer(i)%sides)
    end do
    longer(n+1)%name = name
    longer(n+1)%kind = kind
    longer(n+1)%line = line
    allocate (longer(n+1)%items, source=items)
    allocate (longer(n+1)%sides, source=sides)
    call move_alloc(longer, self%sets)
  end subroutine add_set

  subroutine finish(self)
    !! Arrays have their lengths from here on.
    class(extraction_mesh_type), intent(inout) :: self

    real(wp), allocatable :: x(:,:), w(:)
    integer, allocatable :: line(:)

    allocate (x, source=self%x(:,1:self%nn))
    call move_alloc(x, self%x)
    allocate (w, source=self%w(1:self%nn))
    call move_alloc(w, self%w)
    allocate (line, source=self%node_line(1:self%nn))
    call move_alloc(line, self%node_line)
    allocate (line, source=self%element_line(1:self%elements%ne))
    call move_alloc(line, self%element_line)
    call self%elements%finish()
  end subroutine finish

  pure subroutine check_elements(mesh, first, problems)
    !! Elements name existing nodes, whose weights are positive. Other nodes may have any weight.
    type(extraction_mesh_type), intent(in) :: mesh
    integer, intent(in) :: first                       !! the file's number of node 1
    type(problem_list), intent(inout) :: problems

    logical, allocatable :: told(:)
    integer :: a, e, k

    allocate (told(mesh%nn), source=.false.)
    do e = 1, mesh%elements%ne
      do k = mesh%elements%node_ptr(e), mesh%elements%node_ptr(e+1) - 1
        a = mesh%elements%nodes(k)
        if (a < 1 .or. a > mesh%nn) then
          call problems%add(mesh%element_line(e), 'element ' // whole_number(e-1+first) // &
            ' names node ' // whole_number(a-1+first) // ', which does not exist', &
            'Nodes are numbered from ' // whole_number(first) // ' to ' // &
            whole_number(mesh%nn-1+first))
          exit
        end if
        if (mesh%w(a) > 0 .or. told(a)) cycle
        told(a) = .true.
        call problems%add(mesh%node_line(a), 'node ' // whole_number(a-1+first) // &
          ' has a weight that is not positive, and element ' // whole_number(e-1+first) // &
          ' uses it', 'Only nodes that no element uses may have the weight 0')
      end do
    end do
  end subroutine check_elements

  pure subroutine check_sets(mesh, first, problems)
    !! Sets name existing nodes, elements and sides.
    type(extraction_mesh_type), intent(in) :: mesh
    integer, intent(in) :: first                       !! the file's number of node and element 1
    type(problem_list), intent(inout) :: problems

    character(:), allocatable :: what
    integer :: i, k, most

    do i = 1, size(mesh%sets)
      associate (set => mesh%sets(i))
        what = 'element'
        most = mesh%elements%ne
        if (set%kind == set_of_nodes) then
          what = 'node'
          most = mesh%nn
        end if
        do k = 1, size(set%items)
          if (set%items(k) < 1 .or. set%items(k) > most) then
            call problems%add(set%line, 'set "' // set%name // '" names ' // what // ' ' // &
              whole_number(set%items(k)-1+first) // ', which does not exist', &
              'Numbers are ' // whole_number(first) // ' to ' // whole_number(most-1+first))
            exit
          end if
          if (set%kind /= set_of_sides) cycle
          if (set%sides(k) <= 2*mesh%elements%dp(set%items(k)) .and. set%sides(k) >= 0) cycle
          call problems%add(set%line, 'set "' // set%name // &
            '" names a side that element ' // whole_number(set%items(k)-1+first) // &
            ' does not have', 'BACK and FRONT are sides of volumes alone')
          exit
        end do
      end associate
    end do
  end subroutine check_sets

  pure subroutine used_by_elements(mesh, used)
    type(extraction_mesh_type), intent(in) :: mesh
    logical, allocatable, intent(out) :: used(:)       !! (nn) some element names the node

    integer :: k

    allocate (used(mesh%nn), source=.false.)
    do k = 1, mesh%elements%node_ptr(mesh%elements%ne+1) - 1
      used(mesh%elements%nodes(k)) = .true.
    end do
  end subroutine used_by_elements

  pure subroutine repeated_elements(set, same_as)
    !! Elements that repeat an earlier one exactly: nodes in their order, degrees, operator.
    type(extraction_set_type), intent(in) :: set
    integer, allocatable, intent(out) :: same_as(:)    !! (ne) the earlier one; 0: there is none

    integer, allocatable :: table(:)
    integer(i8) :: code
    integer :: e, k, other, place, n

    allocate (same_as(set%ne), source=0)
    n = 16
    do while (n < 2*set%ne)
      n = 2*n
    end do
    allocate (table(n), source=0)
    do e = 1, set%ne
      code = set%operator_of(e)
      do k = set%node_ptr(e), set%node_ptr(e+1) - 1
        code = ieor(ishftc(code, 7), int(set%nodes(k), i8))
        code = ieor(code, shiftl(code, 13))
        code = ieor(code, shiftr(code, 7))
      end do
      place = 1 + int(iand(ieor(code, shiftr(code, 29)), int(n - 1, i8)))
      do while (table(place) /= 0)
        other = table(place)
        if (same(other, e)) then
          same_as(e) = other
          exit
        end if
        place = 1 + iand(place, n - 1)
      end do
      if (same_as(e) == 0) table(place) = e
    end do

  contains

    pure logical function same(e1, e2)
      integer, intent(in) :: e1, e2

      same = .false.
      if (set%operator_of(e1) /= set%operator_of(e2) .or. set%dp(e1) /= set%dp(e2)) return
      if (any(set%degree(:,e1) /= set%degree(:,e2))) return
      same = all(set%nodes(set%node_ptr(e1):set%node_ptr(e1+1)-1) == &
        set%nodes(set%node_ptr(e2):set%node_ptr(e2+1)-1))
    end function same
  end subroutine repeated_elements

  pure logical function names_a_node_twice(nodes)
    integer, intent(in) :: nodes(:)      !! of an element

    integer :: a

    names_a_node_twice = .false.
    do a = 2, size(nodes)
      names_a_node_twice = any(nodes(1:a-1) == nodes(a))
      if (names_a_node_twice) return
    end do
  end function names_a_node_twice

  pure function whole_number(i) result(text)
    integer, intent(in) :: i
    character(:), allocatable :: text    !! the digits of i

    character(12) :: buffer

    write (buffer, '(i0)') i
    text = trim(buffer)
  end function whole_number

  pure function printable(word) result(text)
    !! A word of a file, which may be anything, for messages.
    character(*), intent(in) :: word
    character(:), allocatable :: text

    integer, parameter :: most = 40
    integer :: i

    text = word(1:min(len(word), most))
    do i = 1, len(text)
      if (iachar(text(i:i)) < 32 .or. iachar(text(i:i)) > 126) text(i:i) = '?'
    end do
    if (len(word) > most) text = text // '...'
  end function printable
end module extraction_mesh
