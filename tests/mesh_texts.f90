module mesh_texts
  !! Mesh files for tests: those of tests/meshes, and their faulty variants.
  use kinds, only: wp
  use extraction_mesh, only: extraction_mesh_type, problem_list
  use extraction_file, only: read_extraction_text, load_text
  use mesh_facts, only: facts_type, gather_facts
  use deck_runs, only: project_file
  implicit none (type, external)
  private
  public :: sample, replaced, problem_of, same_mesh, survive_truncation, survive_mutation

contains

  function sample(name) result(text)
    character(*), intent(in) :: name         !! of a file in tests/meshes
    character(:), allocatable :: text
    logical :: good

    call load_text(project_file('tests/meshes/' // name), text, good)
    if (.not. good) error stop 'a sample of tests/meshes is missing'
  end function sample

  function replaced(text, old, new) result(other)
    !! With the first occurrence of old changed.
    character(*), intent(in) :: text, old, new
    character(:), allocatable :: other
    integer :: i

    i = index(text, old)
    if (i == 0) error stop 'mesh_texts: the sample does not hold what its test changes'
    other = text(1:i - 1) // new // text(i + len(old):)
  end function replaced

  function problem_of(text) result(message)
    !! The first problem: 'line: fact. remedy', with the number of further ones if there are any.
    character(*), intent(in) :: text
    character(:), allocatable :: message
    type(extraction_mesh_type) :: mesh
    type(problem_list) :: problems
    character(60) :: start

    call read_extraction_text(text, mesh, problems)
    message = ''
    if (problems%count == 0) return
    associate (first => problems%list(1))
      write (start, '(i0,a)') first%line, ': '
      message = trim(start) // ' ' // first%fact // '. ' // first%remedy
    end associate
    if (problems%count == 1) return
    write (start, '(a,i0,a)') ' (and ', problems%count - 1, ' more)'
    message = message // trim(start)
  end function problem_of

  logical function same_mesh(a, b)
    !! Bit for bit: nodes, elements, operators, sets.
    type(extraction_mesh_type), intent(in), target :: a, b
    integer :: e, i

    same_mesh = .false.
    if (a%nn /= b%nn .or. a%elements%ne /= b%elements%ne .or. size(a%sets) /= size(b%sets)) return
    if (any(transfer(a%x, [0]) /= transfer(b%x, [0]))) return
    if (any(transfer(a%w, [0]) /= transfer(b%w, [0]))) return
    do e = 1, a%elements%ne
      if (a%elements%dp(e) /= b%elements%dp(e)) return
      if (any(a%elements%degree(:, e) /= b%elements%degree(:, e))) return
      if (a%elements%nen(e) /= b%elements%nen(e)) return
      if (any(a%elements%connectivity(e) /= b%elements%connectivity(e))) return
      if (any(transfer(a%elements%operator(e), [0]) /= transfer(b%elements%operator(e), [0]))) return
    end do
    do i = 1, size(a%sets)
      if (a%sets(i)%name /= b%sets(i)%name .or. a%sets(i)%kind /= b%sets(i)%kind) return
      if (size(a%sets(i)%items) /= size(b%sets(i)%items)) return
      if (any(a%sets(i)%items /= b%sets(i)%items)) return
      if (size(a%sets(i)%sides) /= size(b%sets(i)%sides)) return
      if (any(a%sets(i)%sides /= b%sets(i)%sides)) return
    end do
    same_mesh = .true.
  end function same_mesh

  subroutine read_and_use(text, has_problems)
    !! Whatever the text is: reading it ends, and a mesh without problems can be used.
    character(*), intent(in) :: text
    logical, intent(out) :: has_problems
    type(extraction_mesh_type), target :: mesh
    type(problem_list) :: problems
    type(facts_type) :: facts
    integer :: status, e

    call read_extraction_text(text, mesh, problems)
    has_problems = problems%count > 0
    if (has_problems) return
    call mesh%elements%check(mesh%nn, status, e)
    if (status /= 0) error stop 'a mesh without problems does not hold together'
    call gather_facts(mesh, facts)
  end subroutine read_and_use

  subroutine survive_truncation(text, runs, silent)
    !! The file cut after every character.
    character(*), intent(in) :: text
    integer, intent(out) :: runs           !! how many there were
    integer, intent(out) :: silent         !! the first cut that goes unnoticed, in characters
    logical :: has_problems
    integer :: n

    runs = 0
    silent = len(text) + 1
    do n = len(text) - 1, 0, -1
      call read_and_use(text(1:n), has_problems)
      runs = runs + 1
      if (.not. has_problems) silent = n
    end do
  end subroutine survive_truncation

  subroutine survive_mutation(text, runs, refused)
    !! Every word replaced by what does not belong there.
    character(*), intent(in) :: text
    integer, intent(out) :: runs           !! how many there were
    integer, intent(out) :: refused        !! how many were found faulty
    character(12), parameter :: words(18) = [character(12) :: '', '0', '-1', '1', '2 2', '7', '1.5', '1e999', &
      '-1e300', 'nan', 'Inf', 'belem', 'set', '99999999999', '2147483647', '[', '"', '}']
    character(*), parameter :: blanks = ' ,' // achar(10)
    logical :: has_problems
    integer :: first, i, last

    runs = 0
    refused = 0
    last = 0
    do
      first = verify(text(last + 1:), blanks)
      if (first == 0) exit
      first = last + first
      last = scan(text(first:), blanks)
      if (last == 0) exit
      last = first + last - 2
      do i = 1, size(words)
        call read_and_use(text(1:first - 1) // trim(words(i)) // text(last + 1:), has_problems)
        runs = runs + 1
        if (has_problems) refused = refused + 1
      end do
    end do
  end subroutine survive_mutation
end module mesh_texts
