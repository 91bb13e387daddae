module mesh_files
  !! Files that hold a mesh, of any format: reading them, and what `--check` prints about one.
  use kinds, only: wp
  use messages, only: message_log, deck_place, whole_text
  use extraction_mesh, only: extraction_mesh_type, problem_list, set_of_nodes, set_of_elements, set_of_sides
  use extraction_file, only: read_extraction_file, text_format, unknown_format, load_text
  use mesh_facts, only: facts_type, gather_facts, set_size
  use mesh_store, only: read_mesh_store, is_mesh_store
  use model_summary, only: degrees_text
  implicit none (type, external)
  private
  public :: read_mesh_file, is_mesh_file, report_problems, check_mesh_file

contains

  function is_mesh_file(path) result(answer)
    !! By content. A deck, a file of another kind and one that cannot be read are none.
    character(*), intent(in) :: path
    logical :: answer
    character(:), allocatable :: text

    answer = is_mesh_store(path)
    if (answer) return
    call load_text(path, text, answer)
    if (answer) answer = text_format(text) /= unknown_format
  end function is_mesh_file

  subroutine read_mesh_file(path, mesh, problems)
    character(*), intent(in) :: path
    type(extraction_mesh_type), intent(inout) :: mesh   !! complete if there are no problems
    type(problem_list), intent(inout) :: problems

    if (is_mesh_store(path)) then
      call read_mesh_store(path, mesh, problems)
    else
      call read_extraction_file(path, mesh, problems)
    end if
  end subroutine read_mesh_file

  subroutine report_problems(problems, path, command, order, log)
    type(problem_list), intent(in) :: problems
    character(*), intent(in) :: path
    character(*), intent(in) :: command       !! of the deck that asked for the file; ''
    integer, intent(in) :: order              !! of that command
    type(message_log), intent(inout) :: log
    type(deck_place) :: at
    integer :: i

    at%file = path
    at%order = order
    do i = 1, problems%kept
      at%line = problems%list(i)%line
      call log%add_error(at, command, problems%list(i)%fact, problems%list(i)%remedy)
    end do
    at%line = 0
    if (problems%count > problems%kept) call log%add_error(at, command, whole_text(problems%count - problems%kept)// &
      ' more problems of this file are not shown', '')
  end subroutine report_problems

  subroutine check_mesh_file(path, may_print, unit, log)
    !! What a mesh file holds, or what is wrong with it.
    character(*), intent(in) :: path
    logical, intent(in) :: may_print          !! .false.: it was given as a deck
    integer, intent(in) :: unit               !! where to print
    type(message_log), intent(inout) :: log
    type(extraction_mesh_type), target :: mesh
    type(problem_list) :: problems
    type(deck_place) :: at

    if (.not. may_print) then
      at%file = path
      call log%add_error(at, '', 'this is a mesh, not a deck', &
        'Look at it with --check, or name it in a deck: T-SPline FILE="..."')
      return
    end if
    call read_mesh_file(path, mesh, problems)
    call report_problems(problems, path, '', 0, log)
    if (problems%count == 0) call describe_mesh(mesh, unit)
  end subroutine check_mesh_file

  subroutine describe_mesh(mesh, unit)
    type(extraction_mesh_type), intent(in), target :: mesh
    integer, intent(in) :: unit               !! where to print
    type(facts_type) :: facts
    real(wp) :: length
    character(:), allocatable :: text
    integer :: i
    character(6), parameter :: size_names(3) = [character(6) :: 'length', 'area', 'volume']

    call gather_facts(mesh, facts)
    associate (set => mesh%elements)
      write (unit, '(a)') 'format      '//mesh%format
      write (unit, '(a,i0,a,i0,a)') 'nodes       ', mesh%nn - facts%unused, ' (', facts%unused, ' unused besides)'
      write (unit, '(a,i0,a,i0,a,i0,a)') 'elements    ', set%ne, ' (', set%nop, ' different operators, ', &
        facts%repeated, ' elements repeat another exactly)'
      write (unit, '(a)') 'degrees     '//degrees_text(mesh%elements)
      write (unit, '(a,i0,a,i0)') 'functions   per element ', facts%nen_min, ' to ', facts%nen_max
      write (unit, '(a,es7.1)') 'operators   column sums differ from 1 by at most ', facts%column_error
      write (unit, '(a,es8.1,a,i0,a,i0,a)') 'operators   smallest coefficient ', facts%smallest, ', ', facts%negative, &
        ' below zero in ', facts%negative_elements, ' elements'
      if (facts%double_nodes > 0) write (unit, '(a,i0,a)') 'doubled     ', facts%double_nodes, &
        ' elements name a node twice, whose functions add up'
      write (unit, '(a)') size_names(facts%dp)//'      '//twelve_places(facts%total)
      if (facts%inverted > 0) write (unit, '(a,i0,a,i0,a)') 'inverted    ', facts%inverted, &
        ' elements have det J <= 0 somewhere (the first begins in line ', mesh%element_line(facts%first_inverted), ')'
      do i = 1, size(mesh%sets)
        associate (s => mesh%sets(i))
          select case (s%kind)
          case (set_of_nodes)
            text = whole_text(size(s%items))//' nodes'
          case (set_of_elements)
            text = whole_text(size(s%items))//' elements'
          case default
            call set_size(mesh, s, length)
            text = whole_text(size(s%items))//' sides, '//trim(size_names(max(1, facts%dp - 1)))//' '// &
              twelve_places(length)
          end select
          write (unit, '(a)') 'set         '//s%name//': '//text
        end associate
      end do
    end associate
  end subroutine describe_mesh

  function twelve_places(x) result(text)
    real(wp), intent(in) :: x
    character(:), allocatable :: text
    character(40) :: buffer

    if (abs(x) < 1e-3_wp .or. abs(x) >= 1e15_wp) then
      write (buffer, '(es20.12e3)') x
    else
      write (buffer, '(f32.12)') x
    end if
    text = trim(adjustl(buffer))
  end function twelve_places
end module mesh_files
